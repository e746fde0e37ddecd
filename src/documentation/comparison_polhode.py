"""The same two motions by polhode's Python module. (To be written.)"""
