from __future__ import annotations

import pytest

from tests.pattern import strips
from tests.pattern.group_codes import read_group_codes
from tests.pattern.strips import dxf_bytes, make_pieces
from wrinkle_cad.errors import InputError
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.dxf import write_dxf
from wrinkle_cad.pattern.formats.layers import PROFILES, ROLES, profile_from
from wrinkle_cad.pattern.piece.options import NotchRule, PieceSettings

OWN = """
name = "atom"
[layers]
cut = { layer = "KNIFE1", color = 3 }
sew = "PEN"
notch = { layer = "KNIFE2" }
mountain = { layer = "PEN", line_type = "dotted" }
valley = false
text = false
"""


def written(tmp_path, text):
    path = tmp_path / "own.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_shipped_profile_knows_its_roles_and_keeps_the_cut_apart():
    for name, profile in PROFILES.items():
        assert profile.name == name
        assert set(profile.styles) <= set(ROLES)
        cut = profile.styles["cut"].layer
        assert [role for role, style in profile.styles.items() if style.layer == cut] == ["cut"]


def test_a_map_may_spell_colour_as_earlier_ones_did(tmp_path):
    styles = profile_from(written(tmp_path, OWN.replace("color", "colour"))).styles
    assert styles["cut"].color == 3


def test_a_users_own_map_is_used_where_it_says_something(tmp_path):
    settings = PieceSettings(seam_allowance=(4.0,) * 4, notches_p=NotchRule(count=2), rulings=True)
    pieces = make_pieces(*strips.cylinder(), name="tube", settings=settings)
    path = written(tmp_path, OWN)
    dxf = read_group_codes(dxf_bytes(pieces, profile=path))
    assert {e.layer for e in dxf.entities} == {"KNIFE1", "KNIFE2", "PEN", "GRAIN"}
    assert {e.text(6) for e in dxf.on("PEN", "LINE")} == {"DOTTED"}
    assert dxf.on("KNIFE1")[0].text(62) == "3"
    assert profile_from(path).name == "atom"
    write_dxf(tmp_path / "a.dxf", pieces, profile=str(path))
    assert judge_dxf(tmp_path / "a.dxf", cut_layers=("KNIFE1",)).is_clean


def test_an_empty_map_is_the_cutters(tmp_path):
    profile = profile_from(written(tmp_path, "[layers]\n"))
    assert dict(profile.styles) == dict(PROFILES["cutter"].styles)
    assert profile.name == "own"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("layers = 3", "no table"),
        ("", "no table"),
        ("[layers]\nknife = 'X'", "role 'knife', which is not one of cut, sew"),
        ("[layers]\ncut = 5", "cut = 5"),
        ("[layers]\ncut = false", "cut = False"),
        ("[layers]\nsew = 'Ö'", "layer 'Ö'; a name has 1 to 31 of"),
        ("[layers]\nsew = ''", "1 to 31 of"),
        ("[layers]\nsew = 'a b'", "1 to 31 of"),
        ("[layers]\nsew = { layer = 'A', colour = 0 }", "whole number 1 to 255"),
        ("[layers]\nsew = { layer = 'A', color = true }", "whole number 1 to 255"),
        ("[layers]\nsew = { layer = 'A', line_type = 'wavy' }", "one of CONTINUOUS"),
        ("[layers]\nsew = { layer = 'A', width = 3 }", "sew.width"),
        ("[layers]\nsew = 'CUT'", "sew on the cut layer CUT"),
        ("[layers]\n[more]\n", "key 'more'"),
        ("[layers\n", "cannot be read as TOML"),
    ],
)
def test_a_map_that_means_nothing_is_refused_with_its_reason(text, message, tmp_path):
    with pytest.raises(InputError, match=r"^The profile own\.toml ") as caught:
        profile_from(written(tmp_path, text))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_files_and_unknown_names_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"profile none\.toml cannot be read \(No such file"):
        profile_from(tmp_path / "none.toml")
    with pytest.raises(InputError, match=r"one of cutter, aama, astm or a \.toml file"):
        profile_from("lectra")
