"""Objects of a breakfast table, side by side."""

from __future__ import annotations

from common import tableware
from common.materials import material
from common.objects import exact
from common.parts import bounds
from common.stock import Stock

#: name, position, Euler XYZ, size and centre of the bounding box, mass
THINGS = (
    ("Bowl", (0.322, 0.29, 0), (0, 0, 0), (0.171, 0.171, 0.057), (0, 0, 0.028), 1),
    ("Bread", (0.055, 0.652, 0), (0, 0, 0), (0.333, 0.186, 0.081), (0, 0, 0.04), 1),
    ("ButterDish", (0.128, 0.262, 0.01), (0, 0, -1.57), (0.13, 0.18, 0.034), (0, 0, 0.012), 1),
    ("Cooker", (-0.658, 0, 0), (0, 0, 0), (0.317, 0.28, 0.086), (0.018, 0, -0.006), 1),
    ("Cornflakes", (-0.263, 0.446, 0.15), (0, 0, 0), (0.075, 0.188, 0.3), (0, 0, 0), 0.1),
    ("Cup_Blue", (0.2, -0.323, 0), (0, 0, 0), (0.18, 0.232, 0.191), (0, 0.026, 0), 1),
    ("Cup_Gray", (-0.2, -0.323, 0), (0, 0, 0), (0.163, 0.215, 0.174), (0, 0.026, 0), 1),
    ("Cup_Ocher", (0, -0.323, 0), (0, 0, 0), (0.163, 0.215, 0.174), (0, 0.026, 0), 1),
    ("Fork", (0.102, 0, 0), (0, 0, 0), (0.039, 0.202, 0.017), (0, -0.001, -0.003), 1),
    ("Jam", (-0.083, 0.312, 0.038), (0, 0, 0), (0.056, 0.056, 0.058), (0, 0, -0.009), 1),
    ("Knife", (0.05, 0, 0), (0, 0, 0), (0.039, 0.196, 0.011), (0.006, 0, 0), 1),
    ("Milk", (-0.451, 0.178, 0.092), (0, 0, 0), (0.11, 0.055, 0.2), (0, 0, 0.009), 1),
    ("Napkin", (0.252, 0.479, 0), (0, 0, 0), (0.189, 0.099, 0.001), (0, 0, 0), 0.1),
    ("Nutella", (0, 0.472, 0.022), (0, 0, 0), (0.075, 0.057, 0.084), (0, 0, 0.042), 1),
    ("PancakeMix", (-0.375, 0, 0), (0, 0, 0), (0.056, 0.094, 0.201), (0, 0, 0.01), 0.25),
    ("Placemat", (0.689, 0.486, 0), (0, 0, 0), (0.342, 0.485, 0.008), (0, 0, 0), 0.1),
    ("Plate", (-0.167, 0, 0.014), (0, 0, 0), (0.343, 0.343, 0.021), (0, 0, -0.004), 1),
    ("SoupPlate", (0.378, 0, 0), (0, 0, 0), (0.343, 0.343, 0.039), (0, 0, 0.02), 1),
    ("Spatula", (-0.423, -0.39, 0), (0, 0, 0), (0.072, 0.273, 0.022), (0, 0.087, -0.001), 0.15),
    ("Spoon", (0.158, 0, 0), (0, 0, 0), (0.055, 0.193, 0.018), (0, -0.005, -0.005), 1),
)  # fmt: skip


def build() -> None:
    stock = Stock()
    looks = {
        "Bowl": tableware.bowl(stock, "teal"),
        "Bread": tableware.bread(stock, material("Crust", "#b8742f", 0.85)),
        "ButterDish": tableware.butter_dish(stock),
        "Cooker": tableware.cooker(stock),
        "Cornflakes": tableware.packet(0.075, 0.188, 0.3, "FLAKES", "#d9532c", "#f5b83d"),
        "Cup_Blue": tableware.cup(material("Cup Blue", "#2f62c4", 0.3)),
        "Cup_Gray": tableware.cup(material("Cup Gray", "#8b9299", 0.3)),
        "Cup_Ocher": tableware.cup(material("Cup Ocher", "#c98a2b", 0.3)),
        "Fork": tableware.fork(stock),
        "Jam": tableware.jar(stock, "red", "white"),
        "Knife": tableware.knife(stock),
        "Milk": tableware.packet(0.11, 0.055, 0.2, "MILK", "#3f86d0", "#eaf3fb"),
        "Napkin": tableware.cloth(stock, 0.189, 0.099, "coral", "cream"),
        "Nutella": tableware.jar(stock, "walnut", "white"),
        "PancakeMix": tableware.packet(0.056, 0.094, 0.201, "CAKES", "#3c7f5a", "#f3e9d2"),
        "Placemat": tableware.cloth(stock, 0.342, 0.485, "teal", "cream"),
        "Plate": tableware.plate(stock, 0.12),
        "SoupPlate": tableware.plate(stock, 0.23),
        "Spatula": tableware.spatula(stock),
        "Spoon": tableware.spoon(stock),
    }
    for name, at, turned, size, centre, mass in THINGS:
        parts = looks[name]
        low, high = bounds(parts)
        parts = [part.moved(*-(low + high) / 2) for part in parts]
        still = name == "Cooker"
        settings = {"physics_type": "STATIC"} if still else {"physics_type": "RIGID_BODY", "mass": float(mass)}
        exact(name, parts, size, centre, at, turned, collision="box", **settings)
