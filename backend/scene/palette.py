"""The scene's colours, by what they mean, for the dark and the light page.

The server draws in the dark colours; a light page exchanges them as they arrive, as one server serves both.
"""

from typing import Final, Literal

Theme = Literal["dark", "light"]
Rgb = tuple[int, int, int]

DARK: Final[dict[str, str]] = {
    "link": "#56b4e9",
    "spring": "#e69f00",
    "disturbance": "#d55e00",
    "reference": "#8a94a3",
    "ring": "#6b7585",
    "bolt": "#4b5462",
    "plate": "#2b323c",
    "hub": "#98a2b0",
    "roller": "#a3adba",
    "body": "#444d59",
    "floor": "#1e242c",
}
LIGHT: Final[dict[str, str]] = {
    "link": "#0072b2",
    "spring": "#c77700",
    "disturbance": "#b84a00",
    "reference": "#98a3b1",
    "ring": "#aab4c1",
    "bolt": "#8590a0",
    "plate": "#dde3ea",
    "hub": "#8793a3",
    "roller": "#5d6977",
    "body": "#c3ccd6",
    "floor": "#f7f9fb",
}


def rgb(colour: str) -> Rgb:
    """(red, green, blue), 0 to 255, of a colour like `#56b4e9`."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def exchange(theme: Theme) -> dict[str, Rgb]:
    """What a page of that theme exchanges: "red,green,blue" as the server sends it to the colour to draw."""
    if theme == "dark":
        return {}
    return {",".join(map(str, rgb(colour))): rgb(LIGHT[role]) for role, colour in DARK.items()}
