"""Long work: asked for over REST, watched, cancelled."""
