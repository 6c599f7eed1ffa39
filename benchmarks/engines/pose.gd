# godot --headless --path FOLDER --import, then godot --headless --path FOLDER --script pose.gd
# The engine makes the nodes of puppet.tscn, turns bones and plays animations; the blend of up to four bones is the one
# that Polygon2D hands to the renderer, which on the GPU no script can read back. draw.gd judges that.
extends SceneTree

var worst := 0.0
var scene: Node2D
var polygons: Array[Polygon2D] = []

func _init() -> void:
	var expected: Dictionary = JSON.parse_string(FileAccess.get_file_as_string("res://expected.json"))
	scene = load("res://puppet.tscn").instantiate()
	root.add_child(scene)
	await process_frame
	var skeleton: Skeleton2D = scene.get_node("Skeleton")
	for node in scene.get_children():
		if node is Polygon2D:
			polygons.append(node)
			for k in node.get_bone_count():
				assert(node.get_bone_weights(k).size() == node.polygon.size())
				assert(skeleton.has_node(node.get_bone_path(k)))
	for case in expected.poses:
		for i in skeleton.get_bone_count():
			var bone := skeleton.get_bone(i)
			bone.transform = bone.rest
			bone.rotation -= deg_to_rad(case.turned.get(bone.get_meta("bone"), 0.0))
		judge(case.meshes)
	var player: AnimationPlayer = scene.get_node_or_null("AnimationPlayer")
	for case in expected.moments:
		for i in skeleton.get_bone_count():
			var bone := skeleton.get_bone(i)
			bone.transform = bone.rest
		player.play(case.name)
		player.seek(case.time, true)
		judge(case.meshes)
	var first: Texture2D = polygons[0].texture
	print(JSON.stringify({"worst": worst, "slots": polygons.size(), "bones": skeleton.get_bone_count(),
		"texture": [first.get_width(), first.get_height()], "version": Engine.get_version_info().string}))
	quit()

func judge(meshes: Array) -> void:
	for k in polygons.size():
		var mesh := polygons[k]
		var skeleton: Skeleton2D = mesh.get_node(mesh.skeleton)
		for v in mesh.polygon.size():
			var place := Vector2.ZERO
			var total := 0.0
			for b in mesh.get_bone_count():
				var bone: Bone2D = skeleton.get_node(mesh.get_bone_path(b))
				var weight := mesh.get_bone_weights(b)[v]
				place += weight * (bone.global_transform * bone.get_skeleton_rest().affine_inverse() * mesh.polygon[v])
				total += weight
			worst = max(worst, (place / total).distance_to(Vector2(meshes[k][v][0], -meshes[k][v][1])))
