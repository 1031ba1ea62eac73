"""Translation of messages into languages other than English."""
