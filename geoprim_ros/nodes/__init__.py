"""The nodes; each module has `main(args)` and runs with `python -m geoprim_ros.nodes.NAME`."""
