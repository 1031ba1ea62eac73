"""From the instructors' source to what students get: release, contents page, bundle."""
