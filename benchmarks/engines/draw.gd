# godot --rendering-driver opengl3 --path FOLDER --script draw.gd [-- plain]
# Draws puppet.tscn in each pose of expected.json: pose_K.png. plain: each mesh in its own colour, without texture and
# smooth edges, so that every pixel can be compared.
extends SceneTree

func _init() -> void:
	var expected: Dictionary = JSON.parse_string(FileAccess.get_file_as_string("res://expected.json"))
	var page := SubViewport.new()
	page.size = Vector2i(expected.window[0], expected.window[1])
	page.render_target_update_mode = SubViewport.UPDATE_ALWAYS
	page.transparent_bg = true
	root.add_child(page)
	var scene: Node2D = load("res://puppet.tscn").instantiate()
	scene.position = Vector2(expected.window[0] / 2, expected.origin)
	page.add_child(scene)
	await process_frame
	var skeleton: Skeleton2D = scene.get_node("Skeleton")
	var number := 0
	for node in scene.get_children():
		if node is Polygon2D and OS.get_cmdline_user_args().has("plain"):
			number += 1
			node.texture = null
			node.material = null
			node.color = Color8(number, 255 - number, 128)
	for n in expected.poses.size():
		for i in skeleton.get_bone_count():
			var bone := skeleton.get_bone(i)
			bone.transform = bone.rest
			bone.rotation -= deg_to_rad(expected.poses[n].turned.get(bone.get_meta("bone"), 0.0))
		for k in 4:
			await process_frame
		await RenderingServer.frame_post_draw
		page.get_texture().get_image().save_png("res://pose_%d.png" % n)
	quit()
