#!/usr/bin/env python3
"""Writes the fonts of window and panel: Noto Sans, reduced to the characters in use.

    tools/font.py NotoSans-Regular.ttf NotoSansMono-Regular.ttf NotoSansCJK-Regular.ttc

The sources are Debian's packages `fonts-noto-core`, `fonts-noto-mono` and `fonts-noto-cjk`
(SIL Open Font License 1.1). The script needs `fonttools`. A test of `panel/` fails if a
character is missing, and names this script. The fonts keep all characters of tables, help,
lessons, sample programs and sources. Unifont draws all others that users write.
"""

import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont

ROOT = Path(__file__).resolve().parent.parent
FONTS = ROOT / "assets/fonts"
# The face of the collection with the Chinese forms.
CHINESE = 2
# Accented Latin, Greek, punctuation and signs of both languages, arrows of menus.
SIGNS = "“”‘’…–—、。《》【】（），：；？！％～℃×÷±≤≥≠≈∞√Ø∅⌀←↑→↓↔↕⏴⏵⏶⏷"
ALWAYS = [*range(0x20, 0x180), *range(0x391, 0x3CA), *map(ord, SIGNS)]
# Characters of technical terms that no text contains yet: new texts rarely need a new font.
FIELD = (
    "讯流详框骤细篇健弹逻柜惫栏铺尽介利盒捷贮举悬水阅仪站商割获欲似磁壳员充吃锐讲业柱群匀剪镜绞耦铣艺侵市温捆绑荐微资国享客专购土钝绘智园射杂涌遵集犯买味研万物亦友卸"
    "辉科风滤佳叠阵浮稿著私付抽挥难暗野白斥库臂泄钳树绿棋播承额款授音宣维划官泛础叙室擅恰甲众兼饱耐勾培训恕湿林民政社军象老山她农九战南治领海世金争济思美花声斗今石律"
    "叫织儿矿委办青史劳团酸历克府族亲斯院江王养派育京县听铁价厂校级班师傅毕证书夹爪棒料钢铝铜塑削槽孔螺镗钻铰攻扩锥倒圆弧凹凸粗糙磨损震颤屑油雾热涨缩刚韧脆淬渗镀焊铆"
    "垫圈销键轮皮带链丝杠滚珠导轨联轴器伺服步进脉冲编码栅尺传感探头限撞挡块急停复位归零漂移滞补偿插值拟合样条曲率切矢法"
)
# The first character of the Chinese fonts.
EAST = "\u2e80"
# Line metrics: those of the Chinese font are too high for the rows of a window.
ASCENT, DESCENT = 930, 200


def used():
    """Returns every character that the program can show."""
    found = set(map(chr, ALWAYS)) | set(FIELD)
    folders = [path for path in (ROOT / "assets").rglob("*") if path.is_file()]
    # A terminal has its own fonts.
    folders = [path for path in folders if path.name != "command-line.tsv"]
    for path in [*folders, *ROOT.glob("*/src/**/*.rs")]:
        try:
            found |= set(path.read_text(encoding="utf-8"))
        except UnicodeDecodeError:
            continue  # A picture, or a program in GBK.
    return {character for character in found if character >= " "}


def write(source, face, characters, name, family):
    options = subset.Options()
    options.hinting = False
    options.layout_features = []
    options.desubroutinize = False
    options.name_IDs = [0, 13, 14]
    options.drop_tables += ["GSUB", "GPOS", "GDEF", "BASE", "VORG", "vhea", "vmtx", "DSIG"]
    font = TTFont(source, fontNumber=face)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[ord(character) for character in characters])
    subsetter.subset(font)
    for number, text in [(1, family), (2, "Regular"), (4, family), (6, family.replace(" ", ""))]:
        font["name"].setName(text, number, 3, 1, 0x409)
    head, across, metrics = font["head"], font["hhea"], font["OS/2"]
    across.ascent, across.descent, across.lineGap = ASCENT, -DESCENT, 0
    metrics.sTypoAscender, metrics.sTypoDescender, metrics.sTypoLineGap = ASCENT, -DESCENT, 0
    metrics.usWinAscent, metrics.usWinDescent = ASCENT, DESCENT
    # Reproducible output: no time stamp.
    font.recalcTimestamp = False
    head.modified = head.created
    path = FONTS / name
    font.save(path)
    print(f"{path.relative_to(ROOT)}: {len(font.getBestCmap())} characters, {path.stat().st_size} bytes")


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    latin, mono, chinese = sys.argv[1:]
    characters = used()
    west = {character for character in characters if character < EAST}
    write(latin, -1, west, "latin.ttf", "gsk980td Latin")
    write(mono, -1, west, "mono.ttf", "gsk980td Mono")
    write(chinese, CHINESE, characters - west, "chinese.otf", "gsk980td Chinese")


if __name__ == "__main__":
    main()
