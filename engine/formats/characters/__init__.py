"""Characters from other programs: glTF with morph targets, a folder of OBJ files, ICT-FaceKit."""
