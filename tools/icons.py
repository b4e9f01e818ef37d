#!/usr/bin/env python3
"""Writes the icon font of the window: Phosphor Icons, reduced to the icons in use.

    tools/icons.py Phosphor.ttf

The source is `res/Phosphor.ttf` of the crate `egui-phosphor` 0.14.0 (Phosphor Icons 2.1, MIT
License). The script needs `fonttools`. It reads the code points from
`window/src/widgets/icons.rs`, and a test there fails if an icon is missing.
"""

import re
import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "window/src/widgets/icons.rs"
FONT = ROOT / "assets/fonts/icons.ttf"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    codes = [int(code, 16) for code in re.findall(r"\\u\{([0-9A-F]{4})\}", TABLE.read_text("utf-8"))]
    options = subset.Options()
    options.hinting = False
    options.layout_features = []
    options.name_IDs = [0, 5, 13, 14]
    options.drop_tables += ["GSUB", "GPOS", "GDEF", "DSIG"]
    font = TTFont(sys.argv[1])
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=codes)
    subsetter.subset(font)
    # Reproducible output: no time stamp.
    font.recalcTimestamp = False
    font["head"].modified = font["head"].created
    font.save(FONT)
    print(f"{FONT.relative_to(ROOT)}: {len(font.getBestCmap())} icons, {FONT.stat().st_size} bytes")


if __name__ == "__main__":
    main()
