"""What is asked for and not given."""


class Refusal(Exception):
    """What a browser or a packet asked for and does not get; says why and what to do."""
