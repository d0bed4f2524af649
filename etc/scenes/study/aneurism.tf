# value r g b a      density 0 to 1, opacity per voxel length: vessels, bright in nothing
0.00 0.6 0.1 0.1 0.0
0.18 0.8 0.2 0.1 0.0
0.30 1.0 0.6 0.4 0.4
0.55 1.0 0.9 0.8 0.9
1.00 1.0 1.0 1.0 1.0
