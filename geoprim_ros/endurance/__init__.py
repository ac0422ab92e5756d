"""Trials of a graph that runs for weeks: thousands of frames, killed nodes, starts and stops.

Each is a module that runs with `python -m geoprim_ros.endurance.NAME`; the exit code is 0 where
the graph held out.
"""
