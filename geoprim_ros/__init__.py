"""geoprim on ROS 2: thin rclpy nodes on `geoprim_core`, one a stage."""

from geoprim_ros.environment import prepare

prepare()
