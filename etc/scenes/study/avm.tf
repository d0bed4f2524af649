# value r g b a      opacity per voxel length: vessels with contrast agent in faint tissue
range 0 563
0.00 0.2 0.2 0.3 0.0
0.25 0.3 0.3 0.4 0.0
0.35 0.9 0.3 0.2 0.05
0.50 1.0 0.7 0.5 0.5
1.00 1.0 1.0 0.9 0.95
