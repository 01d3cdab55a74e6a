"""Everything with a clock, a socket, a file or a process: server, live session, compute workers, scene."""
