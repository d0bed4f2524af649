# value r g b a      opacity per voxel length: grey matter, then white; brighter vessels are lost
range 20 125
0.00 0.00 0.00 0.00 0.0
0.18 0.45 0.16 0.16 0.0
0.34 0.74 0.40 0.36 0.15
0.55 0.90 0.64 0.56 0.50
0.75 0.96 0.84 0.74 0.80
1.00 1.00 0.96 0.90 1.0
