"""Walking, in numpy: the only place that knows it. Imports numpy and nothing else.

The column types that flow through the program (`Odometry`, `Contacts`, `Samples`, `Transforms`,
`Arrows`) are defined here, each beside the functions that make it. All lengths are in metres,
forces in newtons, times in nanoseconds since the epoch (int64) unless a name says otherwise;
quaternions are (x, y, z, w).
"""
