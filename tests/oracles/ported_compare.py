"""Compares moves of a ported program with those of the model; moves of cycles, which the manuals
leave open, by their geometry only."""

import math

NEAR = 0.002
LOOSE = {"row", "contour", "pass", "loose", "G76", "G76 end"}


def same(want, got, loose):
    """None, or what differs."""
    if want.kind == "dwell":
        return None if got["kind"] == "dwell" and abs(got["dt"] - want.rate) < 1e-4 else "dwell"
    if got["kind"] == "dwell":
        return "kind"
    # Depths between the first and the last are sums of rounded ones; in inches also distances in
    # a subprogram that is called several times.
    near = {"peck": 0.006, "row": 0.05, "G76": 0.06, "repeated": 0.005}.get(want.rule, NEAR)
    if max(abs(got["x"] - want.x), abs(got["z"] - want.z)) > near:
        return "end"
    if want.kind == "row":
        return None if got["kind"] == "feed" else "kind"
    if want.kind == "pass":
        if got["kind"] != "thread":
            return "kind"
        taper, length, flank = want.center
        # On a cone the half angle meets another line; the manual is silent. In a finishing pass
        # this control goes straight down from the last roughing pass.
        off = abs(got["z0"] - want.z - length - flank)
        if off > 3 * NEAR + (0.03 * abs(flank) if taper else 0) and not (want.rule == "G76 end" and off < 0.06):
            return "flank"
        if abs(got["x0"] - got["x"] - 2 * taper * (got["z0"] - want.z) / length) > 2 * NEAR:
            return "start of the thread"
        return None if want.rate is None or abs(got["lead"] - want.rate) < 1e-4 else "lead"
    if got["kind"] != want.kind:
        return "kind"
    if want.kind in ("cw", "ccw"):
        if math.hypot(got["cx"] - want.center[0], got["cz"] - want.center[1]) > 20 * NEAR:
            return "centre"
    if want.kind == "thread":
        return None if want.rate is None or abs(got["lead"] - want.rate) < 1e-4 else "lead"
    if want.kind != "rapid" and want.rate:
        if got["per"] != want.rate[1]:
            return "feed unit"
        if abs(got["feed"] - want.rate[0]) > 6e-4:
            return "feed"
    return None


def without_rests(moves):
    return [m for m in moves if m["kind"] in ("dwell", "cw", "ccw")
            or max(abs(m["x"] - m["x0"]), abs(m["z"] - m["z0"])) > 0.0011]


def differs(model, made):
    """None, or (class, sentence, line of the foreign program)."""
    made = without_rests(made)
    at = 0
    for index, want in enumerate(model):
        if want.begin and want.kind not in ("cw", "ccw") and max(abs(want.x - want.begin[0]), abs(want.z - want.begin[1])) <= 0.0011:
            continue
        loose = want.rule in LOOSE or want.rule == "cycle" and index and model[index - 1].rule in LOOSE
        # Rounding may leave one peck of a thousandth more.
        reach = 40 if loose else 4 if want.rule == "peck" else 1
        reason = "missing"
        for step, got in enumerate(made[at:at + reach]):
            found = same(want, got, loose)
            if found is None:
                at += step + 1
                break
            if step == 0:
                reason = found
        else:
            if want.rule == "loose":
                continue
            shown = made[at] if at < len(made) else None
            got = f"{shown['kind']} X{shown['x']} Z{shown['z']} centre {shown['cx']}, {shown['cz']} feed {shown['feed']} {shown['per']} lead {shown['lead']} (line {shown['line']})" if shown else "nothing"
            return f"{want.rule or want.kind}: {reason}", f"wanted {want}, made {got}", want.line
    if at < len(made):
        return "more moves", f"{len(made) - at} more: {made[at]}", 0
    return None
