"""What happens live: engine, playback, source thread, publisher, snapshots."""
