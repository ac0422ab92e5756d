"""Files, messages and bags: everything that enters or leaves, without ROS."""
