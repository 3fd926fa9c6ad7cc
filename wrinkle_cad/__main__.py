"""``python -m wrinkle_cad``."""

from __future__ import annotations

import sys

from wrinkle_cad.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
