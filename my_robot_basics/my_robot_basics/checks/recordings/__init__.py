"""When a topic's messages came and what they were: rates, stamps, positions."""
