"""Take in what students handed in, from archives and folders of any course platform."""
