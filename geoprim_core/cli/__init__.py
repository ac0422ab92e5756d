"""The command line: `geoprim detect`, `process`, `evaluate`, `bench` and their helpers."""
