"""The page: plain HTML, CSS and ES modules, found with `importlib.resources.files("frontend_static")`."""
