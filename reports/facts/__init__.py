"""What a report says of a mechanism and its runs, before it is drawn or written."""
