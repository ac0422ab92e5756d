"""The live graph measured: `geoprim bench ros`; `camera` and `reader` are its nodes."""
