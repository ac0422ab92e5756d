"""A CI test without launch files: the graph in this process, a bag into it, its answers checked.

python examples/ci_graph.py bags/demo.mcap config/sorting_cans.yaml
"""

import math
import sys
import time
from pathlib import Path

import rclpy
from geoprim_msgs.msg import Detections
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import CameraInfo, Image

from geoprim_core.io.bags import BagReader
from geoprim_ros.nodes.pipeline import EdgesNode, EllipsesNode, PolygonsNode
from geoprim_ros.spin import take_down

bag, config = sys.argv[1:]
rclpy.init(args=["--ros-args", "--params-file", config])
camera = rclpy.create_node("camera")
infos = camera.create_publisher(CameraInfo, "camera_info", 10)
images = camera.create_publisher(Image, "image", 10)
answers, wanted, found = [], 0, 0
camera.create_subscription(Detections, "detections", answers.append, 10)
executor = SingleThreadedExecutor()
nodes = [EllipsesNode(), PolygonsNode(), EdgesNode(), camera]
for node in nodes:
    executor.add_node(node)
while not (images.get_subscription_count() and infos.get_subscription_count()):
    executor.spin_once(timeout_sec=0.1)

for message in BagReader(bag).messages():
    if message.decoded.header.frame_id != Path(config).stem:  # another scene of the bag
        continue
    if message.topic == "ground_truth":  # a score of 1: an object that has to be found
        truth = [d.ellipse for d in message.decoded.detections if d.score == 1.0]
    elif message.topic == "camera_info":
        infos.publish(message.raw)
    elif message.topic == "image":
        images.publish(message.raw)
        answers.clear()
        end = time.monotonic() + 60.0
        while not answers:
            assert time.monotonic() < end, "the graph does not answer"
            executor.spin_once(timeout_sec=0.1)
        here = [(d.ellipse.x, d.ellipse.y) for d in answers[0].detections]
        wanted += len(truth)
        found += sum(any(math.dist((t.x, t.y), c) < 2.0 for c in here) for t in truth)

print(f"{found} of {wanted} objects found")
assert found >= 0.9 * wanted > 0
take_down(executor, nodes)
