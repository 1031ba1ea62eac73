"""What student code can reach and use up: files, system calls, network, memory, processes."""
