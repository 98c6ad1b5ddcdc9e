"""MuJoCo's models in MJX and in MuJoCo Warp."""
