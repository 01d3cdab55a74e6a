"""REST and websocket: one router a resource; validate, call, answer."""
