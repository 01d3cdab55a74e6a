"""The machine room: everything with a clock, a socket, a file or a wire."""
