"""Pictures as files: PNG, OpenEXR, contact sheets."""
