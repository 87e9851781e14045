(* SPDX-License-Identifier: BSD-3-Clause *)
(* Reads worlds, motions and proofs as doc/CERTIFICATES.md describes them into the checker's types, strictly. Trusted:
   the theorem is about what was read. What the checker does not know is refused by name. *)
module Integer = Z
open Checker
module Z = Integer

exception Bad_input of string
exception Out_of_scope of string

(* ---- Lines and words ---- *)

type lines = { text : string; file : string; mutable at : int; mutable number : int; mutable words : string list }

let fail l why = raise (Bad_input (Printf.sprintf "%s, line %d: %s" l.file l.number why))
let scope l what = raise (Out_of_scope (Printf.sprintf "%s, line %d: %s" l.file l.number what))

(* The next line that is no comment. *)
let rec next l =
  if l.at >= String.length l.text then false
  else begin
    let stop =
      match String.index_from_opt l.text l.at '\n' with Some i -> i | None -> fail l "the last line has no end"
    in
    let line = String.sub l.text l.at (stop - l.at) in
    l.at <- stop + 1;
    l.number <- l.number + 1;
    if line <> "" && line.[0] = '#' then next l
    else begin
      l.words <- String.split_on_char ' ' line;
      if List.mem "" l.words then fail l "words are separated by one space";
      true
    end
  end

let start text file first =
  let l = { text; file; at = 0; number = 0; words = [] } in
  let head = first ^ "\n" in
  let n = String.length head in
  if String.length text < n || String.sub text 0 n <> head then fail l ("the first line is not '" ^ first ^ "'");
  ignore (next l);
  l

let word l = match l.words with [] -> fail l "a word is missing" | w :: rest -> l.words <- rest; w
(* A count of lines to come, of at least [shortest] bytes each. *)
let most_lines = 200 lsl 20
let last l = if l.words <> [] then fail l "there are too many words"

let integer l below =
  let w = word l in
  let n = String.length w in
  if n = 0 || n > 9 || not (String.for_all (fun c -> c >= '0' && c <= '9') w) then fail l ("'" ^ w ^ "' is no number here");
  let value = String.fold_left (fun v c -> (10 * v) + Char.code c - 48) 0 w in
  if value >= below then fail l (Printf.sprintf "the number %d is not below %d" value below);
  value

(* A hexadecimal constant that is a double exactly, as an integer and an exponent of two. *)
let number l =
  let w = word l in
  let wrong () = fail l ("'" ^ w ^ "' is no hexadecimal constant of a double") in
  let negative = w.[0] = '-' in
  let n = String.length w in
  let i = ref (if negative then 1 else 0) in
  if n < !i + 3 || w.[!i] <> '0' || w.[!i + 1] <> 'x' then wrong ();
  i := !i + 2;
  let mantissa = ref 0 and exponent = ref 0 and digits = ref 0 and point = ref false in
  while !i < n && w.[!i] <> 'p' do
    let c = w.[!i] in
    incr i;
    if c = '.' && not !point then point := true
    else begin
      let digit =
        match c with '0' .. '9' -> Char.code c - 48 | 'a' .. 'f' -> Char.code c - 87 | _ -> wrong ()
      in
      incr digits;
      if !digits > 15 then wrong ();
      mantissa := (!mantissa lsl 4) lor digit;
      if !point then exponent := !exponent - 4
    end
  done;
  if !digits = 0 then wrong ();
  if !i < n then begin
    incr i;
    let down = !i < n && w.[!i] = '-' in
    if !i < n && (w.[!i] = '-' || w.[!i] = '+') then incr i;
    if !i >= n || n - !i > 4 then wrong ();
    let p = ref 0 in
    while !i < n do
      (match w.[!i] with '0' .. '9' as c -> p := (10 * !p) + Char.code c - 48 | _ -> wrong ());
      incr i
    done;
    exponent := !exponent + if down then - !p else !p
  end;
  if !mantissa = 0 then { mantissa = Z.zero; exponent = Z.zero }
  else begin
    while !mantissa land 1 = 0 do
      mantissa := !mantissa lsr 1;
      incr exponent
    done;
    if !mantissa >= 1 lsl 53 || !exponent < -1074 then wrong ();
    (* |x| <= 2^40, as for fcl_artic_verify *)
    let bits = Z.numbits (Z.of_int !mantissa) + !exponent in
    if bits > 41 || (bits = 41 && !mantissa <> 1) then fail l ("the number " ^ w ^ " is beyond 2^40");
    { mantissa = Z.of_int (if negative then - !mantissa else !mantissa); exponent = Z.of_int !exponent }
  end

let not_negative l =
  let x = number l in
  if Z.sign x.mantissa < 0 then fail l "a number is negative";
  x

let hex_digit l c =
  match c with
  | '0' .. '9' -> Char.code c - 48
  | 'a' .. 'f' -> Char.code c - 87
  | 'A' .. 'F' -> Char.code c - 55
  | _ -> fail l "a name has a % without two digits after it"

let name l =
  let w = word l in
  let out = Buffer.create 16 in
  let n = String.length w in
  let rec go i =
    if i < n then begin
      let c = w.[i] in
      if Char.code c < 33 || Char.code c > 126 then fail l "a name has a byte that is not escaped";
      if c <> '%' then (Buffer.add_char out c; go (i + 1))
      else begin
        if i + 2 >= n then fail l "a name has a % without two digits after it";
        let high = hex_digit l w.[i + 1] in
        Buffer.add_char out (Char.chr ((16 * high) + hex_digit l w.[i + 2]));
        go (i + 3)
      end
    end
  in
  go 0;
  Buffer.contents out

let three l f =
  let n1 = f l in
  let n2 = f l in
  let n3 = f l in
  { n1; n2; n3 }

(* Nine numbers near a rotation. *)
let rotation l =
  let r1 = three l number in
  let r2 = three l number in
  let r3 = three l number in
  if not (has_rotation { r1; r2; r3; shift = nothing }) then
    fail l "the nine numbers are not known to be within 2^-49 of a rotation's";
  (r1, r2, r3)

let pose l =
  let r1, r2, r3 = rotation l in
  let shift = three l number in
  { r1; r2; r3; shift }

(* ---- The world ---- *)

let rows l what shortest row =
  if not (next l && word l = what) then fail l ("'" ^ what ^ "' is missing");
  let n = integer l most_lines in
  if n = 0 then fail l "the count is 0";
  if n > (String.length l.text - l.at) / shortest then fail l "the text has fewer lines than the count says";
  last l;
  List.init n (fun _ ->
      if not (next l) then fail l "a line is missing";
      let x = row l in
      last l;
      x)

let geometry l =
  match word l with
  | "mesh" ->
      (match word l with
      | "surface" -> ()
      | "solid" -> scope l "mesh solid"
      | _ -> fail l "a mesh is 'surface' or 'solid'");
      last l;
      let vertices = Array.of_list (rows l "vertices" 12 (fun l -> three l number)) in
      let used = Array.make (Array.length vertices) false in
      let corner l =
        let k = integer l (Array.length vertices) in
        used.(k) <- true;
        vertices.(k)
      in
      let triangles =
        rows l "triangles" 6 (fun l ->
            let a = corner l in
            let b = corner l in
            let c = corner l in
            ((a, b), c))
      in
      if Array.exists not used then fail l "a vertex of this mesh is that of no triangle";
      MeshSurface triangles
  | "boxes" ->
      last l;
      Boxes
        (rows l "cells" 24 (fun l ->
             let centre = three l number in
             let half = three l not_negative in
             (centre, half)))
  | "hull" ->
      last l;
      Hull (rows l "vertices" 12 (fun l -> three l number))
  | "box" ->
      let sizes = three l not_negative in
      last l;
      Box sizes
  | "sphere" ->
      let r = not_negative l in
      last l;
      Sphere r
  | "capsule" ->
      let r = not_negative l in
      let length = not_negative l in
      last l;
      Capsule (r, length)
  | "ellipsoid" ->
      let a = three l not_negative in
      last l;
      Ellipsoid a
  | ("cylinder" | "cone") as kind ->
      let r = not_negative l in
      let length = not_negative l in
      last l;
      if kind = "cylinder" then Cylinder (r, length) else Cone (r, length)
  | ("halfspace" | "plane") as kind ->
      let normal = three l number in
      let offset = number l in
      last l;
      if List.for_all (fun x -> Z.sign x.mantissa = 0) [ normal.n1; normal.n2; normal.n3 ] then
        fail l "the normal is the zero vector";
      if kind = "plane" then Plane (normal, offset) else Halfspace (normal, offset)
  | kind -> fail l ("there is no geometry '" ^ kind ^ "'")

(* A world, and what motions are read by. *)
type known = { w : world; body : body array; moved : bool array; turned : bool array }

let most_pairs = 20_000_000

(* Refuses lines without a meaning: whoever wrote them meant something else. *)
let refuse_unused l w geometries used =
  let named = Hashtbl.create 64 in
  List.iter (fun b -> Hashtbl.add named b.body_name b) w.bodies;
  let there what name = if not (Hashtbl.mem named name) then fail l (what ^ " names '" ^ name ^ "': no body is called so") in
  List.iter (fun (a, _) -> there "'margin'" a) w.margins;
  List.iter (fun ((a, b), _) -> there "'margin'" a; there "'margin'" b) w.pair_margins;
  List.iter (fun u -> there "'unchecked'" u.one_name; there "'unchecked'" u.other_name) w.unchecked;
  List.iter (fun (b, _) -> there "'tolerance'" b) w.off.of_bodies;
  for k = 0 to geometries - 1 do
    if not used.(k) then fail l (Printf.sprintf "no body has the geometry %d" k)
  done;
  List.iter
    (fun u ->
      let others = Hashtbl.find_all named u.other_name in
      let pair a b = a.body_frame <> b.body_frame && not (a.body_role = Obstacle && b.body_role = Obstacle) in
      if not (List.exists (fun a -> List.exists (pair a) others) (Hashtbl.find_all named u.one_name)) then
        fail l
          (Printf.sprintf "'unchecked' of '%s' and '%s': no two bodies of these names would be checked" u.one_name u.other_name))
    w.unchecked;
  let all = List.length w.bodies and obstacles = List.length (List.filter (fun b -> b.body_role = Obstacle) w.bodies) in
  if ((all * (all - 1)) - (obstacles * (obstacles - 1))) / 2 > most_pairs then
    fail l "there are more than 20 million pairs to look at"

(* ---- Tolerances ---- *)

(* The lines `tolerance`, in the order of the file. *)
type tolerance_lines = {
  mutable variables : (int * number) list;
  mutable vectors : (int * (int * number)) list;  (* how many slides, and the length *)
  mutable rotations : (int * number) list;
  mutable frames_off : (int * pose_tolerance) list;
  mutable bodies_off : (string * pose_tolerance) list;
}

let zero_number = { mantissa = Z.zero; exponent = Z.zero }
let is_zero x = Z.sign x.mantissa = 0

(* A line after its first word. *)
let tolerance l t variables frames =
  let above_0 x = if is_zero x then fail l "a tolerance is above 0" in
  let fresh list key = if List.mem_assoc key list then fail l "the tolerance is there already" in
  let plain () =
    let v = integer l variables in
    let d = not_negative l in
    above_0 d;
    (v, d)
  in
  let pose () =
    let most_shift = not_negative l in
    let most_angle = not_negative l in
    let pivot = three l number in
    if is_zero most_shift then above_0 most_angle;
    { most_shift; most_angle; pivot }
  in
  (match word l with
  | "variable" ->
      let v, d = plain () in
      fresh t.variables v;
      t.variables <- (v, d) :: t.variables
  | "vector" ->
      let v = integer l variables in
      let count = integer l 4 in
      if count < 2 then fail l "a vector has two or three variables";
      let length = not_negative l in
      above_0 length;
      fresh t.vectors v;
      t.vectors <- (v, (count, length)) :: t.vectors
  | "rotation" ->
      let v, d = plain () in
      fresh t.rotations v;
      t.rotations <- (v, d) :: t.rotations
  | "frame" ->
      let f = integer l frames in
      if f = 0 then fail l "frame 0 is the world";
      fresh t.frames_off f;
      t.frames_off <- (f, pose ()) :: t.frames_off
  | "body" ->
      let b = name l in
      fresh t.bodies_off b;
      t.bodies_off <- (b, pose ()) :: t.bodies_off
  | "speed" -> fail l "'tolerance speed': bodies that move by themselves are not read here (fcl_artic_verify does)"
  | _ -> fail l "a tolerance is of a variable, vector, rotation, frame or body");
  last l

(* Refuses tolerances without a meaning, and those that TUBES refuses: of single variables of a `rotate`, and of vectors
   whose slides do not follow each other, differ in their multiplier, or have tolerances of their own. *)
let check_tolerances l t w =
  let refuse kind v why = fail l (Printf.sprintf "'tolerance %s %d': %s" kind v why) in
  let moved = Hashtbl.create 16 and first = Hashtbl.create 16 and rotated = Hashtbl.create 16 in
  let same_size a b = Z.equal (Z.abs a.mantissa) (Z.abs b.mantissa) && Z.equal a.exponent b.exponent in
  let rec is_vector m v count = function
    | Slide (_, u, n, _) :: rest when u = v && same_size m n -> count = 1 || is_vector m (v + 1) (count - 1) rest
    | _ -> false
  in
  let vectors = List.sort compare (List.map (fun (v, (count, _)) -> (v, count)) t.vectors) in
  (* A variable is in one vector at most: of two that share one, the second begins nowhere. [before]: the elements of the
     frame that come before this one, the last one first. *)
  let of_vector before e rest u m =
    match List.find_opt (fun (v, count) -> u >= v && u < v + count) vectors with
    | None -> ()
    | Some (v, count) ->
        let place = u - v in
        let from = List.rev_append (List.filteri (fun k _ -> k < place) before) (e :: rest) in
        let multiplier = match from with Slide (_, _, n, _) :: _ -> n | _ -> m in
        let slides = match e with Slide _ -> true | _ -> false in
        if (not slides) || place > List.length before || (not (is_vector multiplier v count from)) || List.mem_assoc u t.variables
        then refuse "vector" v "its variables do more than slide one after the other, or have tolerances of their own";
        if place = 0 then Hashtbl.replace first v ()
  in
  let rec elements before = function
    | [] -> ()
    | e :: rest ->
        (match e with
        | Turn (_, u, m, _) | Slide (_, u, m, _) ->
            Hashtbl.replace moved u ();
            of_vector before e rest u m
        | Rotate u ->
            Hashtbl.replace rotated u ();
            for v = u to u + 2 do if List.mem_assoc v t.variables then refuse "variable" v "it is one of a 'rotate'" done);
        elements (e :: before) rest
  in
  List.iter (fun f -> elements [] f.elements) w.frames;
  let needs kind table does (v, _) = if not (Hashtbl.mem table v) then refuse kind v ("no element " ^ does ^ " by it") in
  List.iter (needs "variable" moved "slides or turns") t.variables;
  List.iter (needs "vector" first "is the first of such slides") t.vectors;
  List.iter (needs "rotation" rotated "rotates") t.rotations;
  let parents = Array.of_list (0 :: List.map (fun f -> f.parent) w.frames) in
  let occupied = Array.make (Array.length parents) false in
  List.iter (fun b -> occupied.(b.body_frame) <- true) w.bodies;
  for f = Array.length parents - 1 downto 1 do if occupied.(f) then occupied.(parents.(f)) <- true done;
  List.iter (fun (f, _) -> if not occupied.(f) then refuse "frame" f "no body is in it or below it") t.frames_off

let world text =
  let l = start text "world" "fcl_artic world 1" in
  let variables = ref 0 and frames = ref [] and frame_count = ref 1 and geometries = ref [||] and bodies = ref [] in
  let depths = ref [| 0 |] and used = ref [||] in
  let margins = ref [] and pair_margins = ref [] and unchecked = ref [] in
  let t = { variables = []; vectors = []; rotations = []; frames_off = []; bodies_off = [] } in
  let same a b (c, d) = (a = c && b = d) || (a = d && b = c) in
  while next l do
    match word l with
    | "variable" ->
        ignore (name l);
        last l;
        incr variables
    | "frame" ->
        ignore (name l);
        let parent = integer l !frame_count in
        if !frame_count >= Array.length !depths then depths := Array.append !depths (Array.make !frame_count 0);
        !depths.(!frame_count) <- !depths.(parent) + 1;
        if !depths.(parent) >= 1000 then fail l "a chain of more than 1000 frames is not read";
        let origin = pose l in
        last l;
        frames := { parent; origin; elements = [] } :: !frames;
        incr frame_count
    | ("turn" | "slide") as kind -> (
        match !frames with
        | [] -> fail l "an element comes after its frame"
        | f :: rest ->
            let axis = three l number in
            if List.for_all (fun x -> Z.sign x.mantissa = 0) [ axis.n1; axis.n2; axis.n3 ] then
              fail l "an axis is the zero vector";
            let v = integer l !variables in
            let m = number l in
            let c = number l in
            last l;
            let e = if kind = "turn" then Turn (axis, v, m, c) else Slide (axis, v, m, c) in
            frames := { f with elements = f.elements @ [ e ] } :: rest)
    | "rotate" -> (
        match !frames with
        | [] -> fail l "an element comes after its frame"
        | f :: rest ->
            let v = integer l !variables in
            if v + 2 >= !variables then fail l "'rotate' takes three variables";
            last l;
            frames := { f with elements = f.elements @ [ Rotate v ] } :: rest)
    | "geometry" ->
        geometries := Array.append !geometries [| geometry l |];
        used := Array.append !used [| false |]
    | "body" ->
        let body_role =
          match word l with
          | "link" -> Link
          | "carried" -> Carried
          | "obstacle" -> Obstacle
          | _ -> fail l "a body's role is link, carried or obstacle"
        in
        let body_name = name l in
        let body_frame = integer l !frame_count in
        let number = integer l (Array.length !geometries) in
        !used.(number) <- true;
        let body_geometry = !geometries.(number) in
        let body_place = pose l in
        last l;
        bodies := { body_role; body_name; body_frame; body_place; body_geometry } :: !bodies
    | "margin" ->
        let a = name l in
        if List.length l.words = 1 then begin
          if List.mem_assoc a !margins then fail l "the name has a margin already";
          margins := (a, not_negative l) :: !margins
        end
        else begin
          let b = name l in
          if List.exists (fun (p, _) -> same a b p) !pair_margins then fail l "the pair has a margin already";
          pair_margins := ((a, b), not_negative l) :: !pair_margins
        end;
        last l
    | "unchecked" ->
        let why =
          match word l with
          | "still" -> Still
          | "neighbours" -> Neighbours
          | "allowed" -> Allowed
          | "touch-link" -> Touch_link
          | _ -> fail l "the reason is still, neighbours, allowed or touch-link"
        in
        let a = name l in
        let b = name l in
        last l;
        if List.exists (fun u -> same a b (u.one_name, u.other_name)) !unchecked then fail l "the pair is listed already";
        unchecked := { why; one_name = a; other_name = b } :: !unchecked
    | "tolerance" -> tolerance l t !variables !frame_count
    | kind -> fail l ("there is no item '" ^ kind ^ "'")
  done;
  let off =
    { of_variables = t.variables; of_vectors = List.map (fun (v, (_, length)) -> (v, length)) t.vectors;
      of_rotations = t.rotations; of_frames = t.frames_off; of_bodies = t.bodies_off }
  in
  let w =
    { frames = List.rev !frames; bodies = List.rev !bodies; margins = !margins; pair_margins = !pair_margins;
      unchecked = !unchecked; off }
  in
  refuse_unused l w (Array.length !geometries) !used;
  check_tolerances l t w;
  let moved = Array.make !variables false and turned = Array.make !variables false in
  let element = function
    | Turn (_, v, _, _) | Slide (_, v, _, _) -> moved.(v) <- true
    | Rotate v ->
        Array.fill moved v 3 true;
        turned.(v) <- true
  in
  List.iter (fun f -> List.iter element f.elements) w.frames;
  { w; body = Array.of_list w.bodies; moved; turned }

(* ---- The motion ---- *)

(* A number in [0, 1]. *)
let fraction l =
  let x = not_negative l in
  let bits = Z.numbits x.mantissa + Z.to_int x.exponent in
  if Z.sign x.mantissa > 0 && (bits > 1 || (bits = 1 && not (Z.equal x.mantissa Z.one))) then
    fail l "the time is in [0, 1]";
  x

(* The motion and the hash of its world. *)
let motion text known =
  let variables = Array.length known.moved and bodies = Array.length known.body in
  let l = start text "motion" "fcl_artic motion 1" in
  let world = ref None and margin = ref None and added = ref None and reach = ref None in
  let duration = ref None and until = ref None in
  let values = ref [] and turned = ref [] and left_out = ref [] in  (* of each piece, the last one first *)
  (* A motion of the scope that is read so far. *)
  let zero = { mantissa = Z.zero; exponent = Z.zero } in
  let scoped () =
    let words = Option.value !reach ~default:[] in
    { general_margin = zero; added_margin = zero; scope_self = List.mem "self" words; scope_scene = List.mem "scene" words;
      until = zero; pieces = [] }
  in
  let set item value =
    if !item <> None then fail l "the item is there already";
    if !values <> [] then fail l "the item comes before the first piece";
    item := Some value
  in
  while next l do
    (match word l with
    | "world" -> set world (word l)
    | "margin" -> set margin (not_negative l)
    | "added" -> set added (not_negative l)
    | "scope" ->
        let words = l.words in
        l.words <- [];
        let known = List.sort_uniq compare words in
        if words = [] || List.length known <> List.length words || List.exists (fun x -> x <> "self" && x <> "scene") known
        then fail l "the scope is self, scene or both";
        set reach words
    | "duration" -> set duration (number l)
    | "until" -> set until (fraction l)
    | "piece" ->
        values := Array.make variables [] :: !values;
        turned := ref [] :: !turned;
        left_out := ref [] :: !left_out
    | "q" -> (
        match !values with
        | [] -> fail l "a 'piece' comes first"
        | piece :: _ ->
            let v = integer l variables in
            if not known.moved.(v) then fail l "the variable moves nothing";
            if piece.(v) <> [] then fail l "a piece states a variable twice";
            let n = List.length l.words in
            if n < 1 || n > 6 then fail l "a polynomial has 1 to 6 coefficients";
            piece.(v) <- List.init n (fun _ -> number l))
    | "ignored" -> (
        match !left_out with
        | [] -> fail l "a 'piece' comes first"
        | list :: _ ->
            let a = integer l bodies in
            let b = integer l bodies in
            if a >= b then fail l "of an ignored pair the lower number comes first";
            if not (checked known.w (scoped ()) known.body.(a) known.body.(b)) then fail l "the pair is not checked anyway";
            list := ((a, b), fraction l) :: !list)
    | "orientation" -> (
        match !turned with
        | [] -> fail l "a 'piece' comes first"
        | list :: _ ->
            let v = integer l variables in
            let a, b, c = rotation l in
            if not known.turned.(v) then fail l "the variable is not that of a 'rotate'";
            if List.mem_assoc v !list then fail l "a piece states a variable twice";
            list := (v, ((a, b), c)) :: !list)
    | kind -> fail l ("there is no item '" ^ kind ^ "'"));
    last l
  done;
  let need what item = match !item with Some x -> x | None -> fail l (what ^ " is missing") in
  let reach = need "scope" reach in
  if !values = [] then fail l "there is no piece";
  let piece q (r, i) = { polynomials = Array.to_list q; orientations = !r; ignored = !i } in
  let pieces = List.rev (List.map2 piece !values (List.combine !turned !left_out)) in
  ( { general_margin = need "margin" margin; added_margin = Option.value !added ~default:zero;
      scope_self = List.mem "self" reach; scope_scene = List.mem "scene" reach; until = need "until" until; pieces },
    need "world" world )

(* ---- Certificates ---- *)

type bytes = { data : string; mutable pos : int }

let take b n =
  if n < 0 || n > String.length b.data - b.pos then raise (Bad_input "the proof ends too early");
  b.pos <- b.pos + n;
  String.sub b.data (b.pos - n) n

let byte b = Char.code (take b 1).[0]
let little b n =
  let s = take b n in
  let v = ref 0 in
  for k = n - 1 downto 0 do
    v := (!v lsl 8) lor Char.code s.[k]
  done;
  !v
let signed b n =
  let v = little b n in
  if v >= 1 lsl ((8 * n) - 1) then v - (1 lsl (8 * n)) else v

let varint b =
  let rec go shift value =
    if shift > 28 then raise (Bad_input "a varint has more than 32 bits");
    let x = byte b in
    let value = value lor ((x land 127) lsl shift) in
    if x land 128 <> 0 then go (shift + 7) value
    else if value lsr 32 <> 0 || (x = 0 && shift > 0) then raise (Bad_input "a varint is not in its shortest form")
    else value
  in
  go 0 0

(* The motion and the proof of each record. *)
let records file =
  let b = { data = file; pos = 0 } in
  let rec go acc =
    if b.pos = String.length file then List.rev acc
    else begin
      let version = take b 4 in
      if version = "FAC1" then raise (Bad_input "a record is of format 1, which is not read here: ask for it anew");
      if version <> "FAC2" then raise (Bad_input "a record does not begin with FAC2");
      let motion = take b (little b 4) in
      let proof = take b (little b 4) in
      go ((motion, proof) :: acc)
    end
  in
  go []

let rec node b depth times =
  if depth > 400 then raise (Bad_input "the proof is more than 400 nodes deep");
  let cut times f =
    let first = node b (depth + 1) times in
    let second = node b (depth + 1) times in
    f first second
  in
  let two f = cut times f in
  match byte b with
  | k when k < 6 ->
      let n = if k < 3 then 2 else 4 in
      let entry () = Z.shift_left (Z.of_int (signed b n)) (65 - (8 * n)) in
      let x = entry () in
      let y = entry () in
      let z = entry () in
      Sep ((match k mod 3 with 0 -> InWorld | 1 -> InOwn | _ -> InPartners), x, y, z)
  | 0x09 -> AtWall false
  | 0x0a -> AtWall true
  | 0x10 ->
      if times = 60 then raise (Bad_input "time is cut more than 60 times");
      cut (times + 1) (fun l r -> Time (l, r))
  | 0x11 ->
      let c = varint b in
      two (fun l r -> Partners (c, l, r))
  | 0x12 ->
      let c = varint b in
      two (fun l r -> Own (c, l, r))
  | 0x13 ->
      let c = varint b in
      two (fun l r -> Other (c, l, r))
  | 0x14 -> raise (Out_of_scope "the proof: SOLID")
  | k -> raise (Bad_input (Printf.sprintf "there is no node of kind %d" k))

(* A double that is a number, of magnitude 2^40 at most. *)
let double b =
  let bits = String.get_int64_le (take b 8) 0 in
  let field shift mask = Int64.to_int (Int64.logand (Int64.shift_right_logical bits shift) mask) in
  let biased = field 52 0x7ffL and low = field 0 0xfffffffffffffL in
  let mantissa = if biased = 0 then low else low lor (1 lsl 52) in
  let exponent = max biased 1 - 1075 in
  let bits_in_all = Z.numbits (Z.of_int mantissa) + exponent in
  if bits_in_all > 41 || (bits_in_all = 41 && mantissa land (mantissa - 1) <> 0) then
    raise (Bad_input "a witness has a number beyond 2^40");
  let rec least m e = if m land 1 = 0 then least (m lsr 1) (e + 1) else (m, e) in
  let mantissa, exponent = if mantissa = 0 then (0, 0) else least mantissa exponent in
  { mantissa = Z.of_int (if Int64.compare bits 0L < 0 then - mantissa else mantissa); exponent = Z.of_int exponent }

(* A contact: in a piece, at a time, of bodies [lower] < [upper]; the witness is about a point of the lower one in the
   upper one if [of_lower], else the other way round. *)
type contact = { piece : int; lower : int; upper : int; time : number; of_lower : bool; witness : witness }

let pieces_of = function MeshSurface ts -> List.length ts | Boxes cells -> List.length cells | _ -> 1

let below what b n =
  let k = varint b in
  if k >= n then raise (Bad_input ("a witness names " ^ what ^ " that is not there"));
  k

let place b g =
  let piece = below "a piece" b (pieces_of g) in
  let weights vertices =
    let n = varint b in
    if n = 0 || n > 16 then raise (Bad_input "a witness' point has 1 to 16 weights");
    let list =
      List.init n (fun _ ->
          let vertex = below "a vertex" b vertices in
          (vertex, Z.of_int (little b 4)))
    in
    if List.for_all (fun (_, x) -> Z.sign x = 0) list then raise (Bad_input "a witness' weights are all 0");
    Mean (piece, list)
  in
  match g with
  | MeshSurface _ -> weights 3
  | Hull points -> weights (List.length points)
  | _ ->
      let n1 = double b in
      let n2 = double b in
      let n3 = double b in
      Given (piece, { n1; n2; n3 })

let contact b known pieces =
  let piece = varint b in
  let one = varint b in
  let other = varint b in
  let time = double b in
  let bodies = Array.length known.body in
  if piece >= pieces then raise (Bad_input "the contact is in a piece that is not there");
  if one >= bodies || other >= bodies then raise (Bad_input "the contact's body is not there");
  if Z.sign time.mantissa < 0 || Z.gt time.mantissa (Z.shift_left Z.one (max 0 (- (Z.to_int time.exponent)))) then
    raise (Bad_input "the contact's time is not in [0, 1]");
  let kind = byte b in
  if kind > 4 then raise (Bad_input (Printf.sprintf "there is no witness of kind %d" kind));
  let owner, holder = if kind land 1 = 1 then (other, one) else (one, other) in
  let a = known.body.(owner).body_geometry and c = known.body.(holder).body_geometry in
  let witness =
    if kind <= 1 then begin
      let triangle = varint b in
      let edge = varint b in
      let crossed = varint b in
      match (a, c) with
      | MeshSurface _, MeshSurface _ when triangle < pieces_of a && crossed < pieces_of c && edge <= 2 ->
          Cross (triangle, edge, crossed)
      | _ -> raise (Bad_input "CROSS names a triangle or edge that is not there")
    end
    else if kind <= 3 then begin
      let p = place b a in
      let container = below "a piece" b (pieces_of c) in
      let four = match c with Hull points -> List.init 4 (fun _ -> below "a vertex" b (List.length points)) | _ -> [] in
      Inside (p, container, four)
    end
    else begin
      let p = place b a in
      let q = place b c in
      Near (p, q)
    end
  in
  { piece; lower = min one other; upper = max one other; time; of_lower = owner <= holder; witness }

(* The hash of the motion, the roots, and a contact that comes after them. *)
let proof data known pieces =
  let b = { data; pos = 0 } in
  let hash = take b 32 in
  let rec go acc =
    if b.pos = String.length data then (hash, List.rev acc, None)
    else if data.[b.pos] = '\x20' then begin
      ignore (byte b);
      let c = contact b known pieces in
      if b.pos < String.length data then raise (Bad_input "the proof has bytes after its end");
      (hash, List.rev acc, Some c)
    end
    else go (node b 0 0 :: acc)
  in
  go []
