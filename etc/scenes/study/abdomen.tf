# value r g b a      Hounsfield units, opacity per voxel length: faint tissue, vessels, bone
range -1000 1500
0.00 0.2 0.1 0.1 0.0
0.40 0.7 0.4 0.3 0.0
0.43 0.7 0.4 0.3 0.004
0.46 0.9 0.4 0.3 0.02
0.50 1.0 0.8 0.6 0.5
1.00 1.0 1.0 0.95 1.0
