"""The start of the tests of tools/python, which they import before the package: without numpy they are skipped (exit code 77)."""
import pathlib
import sys

try:
    import numpy as np  # noqa: F401
except ImportError:
    print("skipped: this python3 has no numpy (Debian: python3-numpy)")
    sys.exit(77)

repo = pathlib.Path(__file__).resolve().parents[2]
tools = repo / "tools" / "python"
sys.path.insert(0, str(tools))
