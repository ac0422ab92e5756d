"""Installs geoprim_core and geoprim_ros, for colcon (ament_python) and for pip alike."""

from glob import glob

from setuptools import find_packages, setup

PACKAGE = "geoprim_ros"

NODES = [
    "edges_node",
    "polygons_node",
    "ellipses_node",
    "detector_node",
    "lifecycle_detector",
    "overlay_node",
    "markers_node",
    "view_node",
    "pipeline",
    "bag_player",
    "bag_recorder",
]

# Of the library and its bags; ROS comes from its own packages. Versions: tools/constraints.txt.
LIBRARY = [
    "lz4",
    "mcap",
    "numba",
    "numpy",
    "opencv-python-headless",
    "PyYAML",
    "rosbags",
    "scipy",
    "tqdm",
    "zstandard",
]

setup(
    name=PACKAGE,
    version="0.1.0",
    description="Geometric primitives for robot perception: a pure library and ROS 2 nodes on it",
    license="Apache-2.0",
    maintainer="geoprim maintainers",
    maintainer_email="maintainers@geoprim.invalid",
    packages=[*find_packages(include=["geoprim_core*", "geoprim_ros*"]), "geoprim_core.io.msg"],
    package_dir={"geoprim_core.io.msg": "msg_defs/geoprim_msgs/msg"},
    package_data={"geoprim_core.io.msg": ["*.msg"], "geoprim_core": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/config", sorted(glob("config/*"))),
    ],
    python_requires=">=3.11",
    install_requires=LIBRARY,
    extras_require={
        "plots": ["matplotlib", "scikit-image"],
        "view": ["foxglove-sdk"],
        "test": ["hypothesis", "pytest"],
    },
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "geoprim = geoprim_core.cli.main:main",
            *(f"{node} = geoprim_ros.nodes.{node}:main" for node in NODES),
        ]
    },
)
