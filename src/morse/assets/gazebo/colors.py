"""The materials that Gazebo brings with it, which files name without containing them."""

from __future__ import annotations

Color = tuple[float, float, float]

#: name after ``Gazebo/`` to the diffuse colour, sRGB; pictures are represented by their mean colour
_COLORS: dict[str, Color] = {
    "Black": (0.0, 0.0, 0.0),
    "Blue": (0.0, 0.0, 1.0),
    "BlueLaser": (0.0, 0.0, 1.0),
    "Bricks": (0.55, 0.35, 0.28),
    "CeilingTiled": (0.8, 0.8, 0.78),
    "Chrome": (0.75, 0.75, 0.75),
    "DarkGray": (0.175, 0.175, 0.175),
    "DarkGrey": (0.175, 0.175, 0.175),
    "DarkMagentaTransparent": (0.7, 0.0, 0.7),
    "DarkOrangeTransparent": (1.0, 0.55, 0.0),
    "DarkYellow": (0.7, 0.7, 0.0),
    "FlatBlack": (0.1, 0.1, 0.1),
    "FloorTiled": (0.7, 0.7, 0.68),
    "Gold": (0.8, 0.65, 0.12),
    "Grass": (0.33, 0.45, 0.2),
    "Gray": (0.7, 0.7, 0.7),
    "Green": (0.0, 1.0, 0.0),
    "Grey": (0.7, 0.7, 0.7),
    "Indigo": (0.33, 0.0, 0.5),
    "LightWood": (0.75, 0.6, 0.42),
    "Motorway": (0.3, 0.3, 0.3),
    "Orange": (1.0, 0.51, 0.05),
    "PaintedWall": (0.85, 0.83, 0.77),
    "PioneerBody": (0.8, 0.1, 0.1),
    "Purple": (1.0, 0.0, 1.0),
    "Red": (1.0, 0.0, 0.0),
    "RedBright": (0.87, 0.26, 0.07),
    "Residential": (0.35, 0.35, 0.35),
    "Road": (0.35, 0.35, 0.35),
    "Rocky": (0.45, 0.42, 0.38),
    "SkyBlue": (0.13, 0.44, 0.7),
    "Steel": (0.6, 0.6, 0.62),
    "Turquoise": (0.0, 1.0, 1.0),
    "White": (1.0, 1.0, 1.0),
    "WhiteGlow": (1.0, 1.0, 1.0),
    "Wood": (0.6, 0.42, 0.25),
    "WoodFloor": (0.55, 0.38, 0.22),
    "WoodPallet": (0.65, 0.5, 0.33),
    "WoodTile": (0.55, 0.38, 0.22),
    "Yellow": (1.0, 1.0, 0.0),
    "ZincYellow": (0.97, 0.95, 0.21),
}


def color_of(name: str) -> Color | None:
    """The colour of a material of Gazebo; variants that glow or are transparent have that of the plain one."""
    prefix, _, own = name.partition("/")
    if prefix != "Gazebo":
        return None
    for suffix in ("", "Glow", "TransparentOverlay", "Transparent", "GlowOutline"):
        if own.endswith(suffix) and (color := _COLORS.get(own.removesuffix(suffix))):
            return color
    return None
