"""Job files that no one would write, by the thousand: from a grammar of valid jobs and of what spoils them."""
