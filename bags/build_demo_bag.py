"""Build the demo bag: `python bags/build_demo_bag.py [OUTPUT]`, by default bags/demo.mcap."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from geoprim_core.errors import GeoprimError  # noqa: E402
from geoprim_core.io.demo_bag import build_demo_bag  # noqa: E402


def main() -> int:
    """Write the bag and list its sequences."""
    parser = argparse.ArgumentParser(description="Build the demo bag.")
    default = ROOT / "bags" / "demo.mcap"
    parser.add_argument("output", nargs="?", type=Path, default=default, metavar="OUTPUT")
    output = parser.parse_args().output
    try:
        sequences = build_demo_bag(output)
    except GeoprimError as problem:
        print(f"build_demo_bag: {problem}", file=sys.stderr)
        return 1
    for row in sequences:
        print(f"{row.name:20} {row.frames:4} frames  {row.content} ({row.source})")
    print(f"{output}: {output.stat().st_size / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
