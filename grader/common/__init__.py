"""What every part uses: errors, files, text, names of students, dates, a process that parses."""
