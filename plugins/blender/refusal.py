"""What cannot be rendered as Blender means it."""


class Refused(Exception):
    """A thing of the scene, by its name, and why it cannot be rendered."""

    def __init__(self, name, reason):
        super().__init__(f'"{name}": {reason}')
