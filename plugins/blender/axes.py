"""Blender's world has z up, the library's y: (x, y, z) here is (x, z, -y) there."""

from mathutils import Matrix

Y_UP = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def point(place):
    """A place or a direction."""
    x, y, z = place
    return [x, z, -y]


def matrix(matrix_world):
    """From an object's space to the library's world: 16 numbers, row by row."""
    return [value for row in Y_UP @ matrix_world for value in row]
