# value r g b a      Hounsfield units from LO to HI, opacity per voxel length: skin and muscle,
#                    translucent, and nothing of bone, which is a surface (skin.scene)
range -1000 2000
0.00 0.90 0.60 0.48 0.0
0.18 0.90 0.60 0.48 0.0
0.24 0.95 0.72 0.60 0.09
0.30 0.95 0.70 0.58 0.03
0.35 0.80 0.36 0.30 0.016
0.38 0.80 0.36 0.30 0.0
1.00 0.80 0.36 0.30 0.0
