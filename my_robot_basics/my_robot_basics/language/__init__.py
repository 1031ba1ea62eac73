"""Other languages than English: what is translated, and how a sentence is found there."""
