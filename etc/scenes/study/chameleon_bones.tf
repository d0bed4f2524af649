# value r g b a      opacity per voxel length: all tissues mostly transparent, the skeleton least
range 0 1
0.00 0.02 0.10 0.20 0.0
0.06 0.10 0.40 0.70 0.0
0.16 0.20 0.60 1.00 0.0020
0.28 0.95 0.30 0.25 0.0025
0.44 0.40 0.85 1.00 0.0080
0.54 1.00 0.70 0.30 0.0200
0.78 1.00 0.88 0.60 0.130
1.00 1.00 0.96 0.85 0.25
