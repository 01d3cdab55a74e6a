"""The page at /scene/: viser's own client, with a preface that fits it into the dashboard."""

import html
import importlib.util
import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Final

from backend.scene.geometry import MAGNIFICATION
from backend.scene.palette import Theme, exchange

CONTENT_SECURITY_POLICY: Final = "; ".join(
    [
        "default-src 'none'",
        # viser's single file unpacks itself: an inline script that runs WebAssembly and adds another inline script.
        "script-src 'unsafe-inline' 'wasm-unsafe-eval'",
        "worker-src blob:",
        "style-src 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src data:",
        # Keeps viser's ?websocket= and ?playbackPath= from reaching another server.
        "connect-src 'self' data: blob:",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    ]
)
BACKGROUND: Final[dict[Theme, tuple[str, str, str]]] = {
    "dark": ("#1d232b", "#14181e", "#8a94a3"),
    "light": ("#ffffff", "#f3f6f9", "#5d6977"),
}
"""Middle and rim of the background, and the colour of small text."""


@cache
def scene_page(theme: Theme) -> bytes:
    """viser's client page in that theme."""
    page = _client_page().read_text(encoding="utf-8")
    # The preface must run before viser's own script, which reads the address and starts its worker.
    return page.replace("<head>", "<head>" + _preface(theme), 1).encode("utf-8")


@cache
def waiting_page(theme: Theme, sentence: str) -> bytes:
    """A calm page that says why there is no scene yet and asks again every second."""
    middle, rim, text = BACKGROUND[theme]
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Scene</title>'
        f'<meta http-equiv="refresh" content="1"><style>html{{height:100%}}body{{margin:0 24px;height:100%;'
        f"display:grid;place-items:center;color:{text};background:radial-gradient(circle at 45% 40%,{middle},{rim});"
        f"font:12.5px system-ui,sans-serif;text-align:center}}</style></head>"
        f"<body><p>{html.escape(sentence)}</p></body></html>"
    ).encode()


def _client_page() -> Path:
    """The client page that viser ships; found without importing viser, which this process does not need."""
    package = importlib.util.find_spec("viser")
    if package is None or package.origin is None:
        raise RuntimeError("viser is not installed, but the 3D scene needs it; install vssea with its dependencies.")
    return Path(package.origin).parent / "client" / "build" / "index.html"


def _preface(theme: Theme) -> str:
    """Style and script to be read before anything of viser's."""
    middle, rim, text = BACKGROUND[theme]
    folder = files("backend.scene")
    style = folder.joinpath("preface.css").read_text(encoding="utf-8")
    script = folder.joinpath("preface.js").read_text(encoding="utf-8")
    settings = {"exchange": exchange(theme), "note": f"bending \N{MULTIPLICATION SIGN} {MAGNIFICATION:g}"}
    colours = f":root{{--middle:{middle};--rim:{rim};--text:{text};color-scheme:{theme}}}"
    return (
        f"<style>{colours}{style}</style>"
        f"<script>window.vsseaScene = {json.dumps(settings, ensure_ascii=False)};</script><script>{script}</script>"
    )
